//! Whether memory and disk suffice for a conversion.

use crate::block::BlockGrid;
use crate::{ConvertError, Estimate, Options};
use std::path::Path;

/// What a thread works with: samples and sums of a block, encoded blocks on their way to the file.
const BYTES_PER_THREAD: u64 = 24 << 20;
/// The rest: the palette, the index of blocks, what the allocator keeps.
const OTHER_BYTES: u64 = 64 << 20;
/// What finding the inside takes for each block of the cube, empty ones too: its place, its set, its code.
const FLOOD_BYTES_PER_BLOCK: u64 = 16;

/// Bytes that waiting voxels may take in memory, of what the options allow. The mesh and what has been made of it are in
/// memory already.
///
/// # Errors
/// [`ConvertError::MemoryBound`] and [`ConvertError::DiskSpace`], unless the options say to try nevertheless.
pub(crate) fn room_in_memory(estimate: &Estimate, options: &Options) -> Result<u64, ConvertError> {
    let room = match options.memory {
        None => u64::MAX,
        Some(bound) => {
            let in_use = octvox_cli::memory_in_use_bytes().unwrap_or(0);
            let threads = BYTES_PER_THREAD * rayon::current_num_threads() as u64;
            let needed = in_use + OTHER_BYTES + threads + flood_bytes(options);
            if bound < needed && !options.force {
                return Err(ConvertError::MemoryBound { needed, bound });
            }
            // An eighth for the gaps between blocks of memory that are taken and given back.
            bound.saturating_sub(needed) / 8 * 7
        }
    };
    if !options.force {
        check_disk(estimate, options, room)?;
    }
    Ok(room)
}

/// Bytes that finding the inside takes, beside the blocks that wait.
fn flood_bytes(options: &Options) -> u64 {
    if options.solid { FLOOD_BYTES_PER_BLOCK << (3 * BlockGrid::new(options.depth).top_depth()) } else { 0 }
}

fn check_disk(estimate: &Estimate, options: &Options, room: u64) -> Result<(), ConvertError> {
    // Scanned voxels and trees are both in the temporary file in the end.
    let spilled = estimate.waiting_bytes.saturating_sub(room).saturating_mul(2);
    // Where the output goes is known only if its folder is.
    let file = if options.folder.is_some() { estimate.file_bytes } else { 0 };
    let needed = spilled.saturating_add(file);
    let folder = options.folder_of_temporary_files();
    match free_bytes(&folder) {
        Some(free) if free < needed => Err(ConvertError::DiskSpace { folder, needed, free }),
        _ => Ok(()),
    }
}

/// Free space on the disk of a folder, in bytes; `None` if the system does not tell.
fn free_bytes(folder: &Path) -> Option<u64> {
    // The current folder has an empty path.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    fs4::available_space(folder).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(waiting_bytes: u64, file_bytes: u64) -> Estimate {
        Estimate { leaf_voxels: 1, file_bytes, waiting_bytes }
    }

    #[test]
    fn a_bound_leaves_what_is_not_in_use() {
        let room = |memory| room_in_memory(&estimate(0, 0), &Options { memory, ..Options::default() });
        assert_eq!(room(None).unwrap(), u64::MAX);
        let [four, five] = [4 << 40, 5 << 40].map(|bound: u64| room(Some(bound)).unwrap());
        assert!(four < 4 << 40 && five > four);
        let error = room(Some(1000)).unwrap_err();
        assert!(matches!(error, ConvertError::MemoryBound { bound: 1000, .. }), "{error}");
        let forced = Options { memory: Some(1000), force: true, ..Options::default() };
        assert_eq!(room_in_memory(&estimate(0, 0), &forced).unwrap(), 0);
    }

    #[test]
    fn finding_the_inside_takes_memory_for_each_block() {
        let bytes = |depth, solid| flood_bytes(&Options { depth, solid, ..Options::default() });
        assert_eq!(bytes(14, false), 0);
        // 256 blocks per axis.
        assert_eq!(bytes(14, true), 16 * 256 * 256 * 256);
        assert_eq!(bytes(3, true), 16);
    }

    #[test]
    fn a_full_disk_is_noticed_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let options = Options { folder: Some(folder.path().to_owned()), ..Options::default() };
        let free = free_bytes(folder.path()).unwrap();
        assert!(room_in_memory(&estimate(1 << 60, 1), &options).is_ok());
        let error = room_in_memory(&estimate(1, u64::MAX / 2), &options).unwrap_err();
        assert!(matches!(error, ConvertError::DiskSpace { .. }), "{error}");
        // Bounded memory moves the waiting voxels to the disk.
        let bounded = Options { memory: Some(1 << 40), ..options.clone() };
        assert!(room_in_memory(&estimate((2 << 40) + free, 1), &bounded).is_err());
        let forced = Options { force: true, ..bounded };
        assert!(room_in_memory(&estimate((2 << 40) + free, 1), &forced).is_ok());
    }
}
