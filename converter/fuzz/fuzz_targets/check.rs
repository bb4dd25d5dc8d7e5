//! What every target does with the bytes of a file.

use octvox_cli::Progress;
use octvox_converter::{Options, convert, read_mesh};
use octvox_format::{Reader, summarize};

/// Reads the bytes as a file of this name and converts what is read: an error, or a file that makes sense.
///
/// The name is one of a folder that does not exist, so that nothing else is read.
pub fn check(name: &str, bytes: &[u8]) {
    let Ok(mesh) = read_mesh(format!("no such folder/{name}").as_ref(), bytes) else { return };
    assert!(!mesh.triangles().is_empty());
    let mut file = Vec::new();
    let options = Options { depth: 4, conservative: bytes.len() % 2 == 1, ..Options::default() };
    if let Ok(report) = convert(&mesh, &options, &Progress::hidden(), &mut file) {
        let summary = summarize(Reader::new(&file[..]).unwrap()).unwrap();
        assert!(summary.is_valid());
        assert!(report.leaf_voxels > 0);
    }
}
