//! The colours of a file that has none of its own.

/// MagicaVoxel's own colours, for the indices 1 to 255: all of six steps of red, green and blue, from white on, blue being
/// the fastest, but not black; then ten shades each of red, green, blue and grey.
pub(super) fn default_palette() -> Vec<[u8; 3]> {
    const STEPS: [u8; 6] = [0xFF, 0xCC, 0x99, 0x66, 0x33, 0x00];
    const SHADES: [u8; 10] = [0xEE, 0xDD, 0xBB, 0xAA, 0x88, 0x77, 0x55, 0x44, 0x22, 0x11];
    let mut colors = Vec::with_capacity(255);
    for red in STEPS {
        for green in STEPS {
            colors.extend(STEPS.map(|blue| [red, green, blue]));
        }
    }
    // Black.
    colors.pop();
    for channels in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]] {
        colors.extend(SHADES.map(|shade| channels.map(|channel| channel * shade)));
    }
    colors
}
