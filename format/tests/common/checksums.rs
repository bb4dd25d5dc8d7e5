//! The checksums of a file of version 5, computed anew: what somebody does who damages a file on purpose.

/// Where the first section behind the header begins.
const MATERIALS: usize = 96;
/// Length of what stands before the stored bytes of a section.
pub const HEAD: usize = 32;

/// CRC-32 bit by bit.
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut register = u32::MAX;
    for byte in bytes {
        register ^= u32::from(*byte);
        for _ in 0..8 {
            register = if register & 1 == 1 { register >> 1 ^ 0xEDB8_8320 } else { register >> 1 };
        }
    }
    !register
}

/// The beginnings of the sections, as far as their lengths lead.
pub fn sections(file: &[u8]) -> Vec<usize> {
    let mut starts = Vec::new();
    let mut start = MATERIALS;
    while let Some(length) = file.get(start + 4..start + 8)
        && start + HEAD <= file.len() - 36
    {
        starts.push(start);
        start += HEAD + u32::from_le_bytes(length.try_into().unwrap()) as usize;
    }
    starts
}

/// Computes all checksums anew, those in an uncompressed index too, so that other checks are reached.
pub fn repair(file: &mut [u8]) {
    if file.len() < MATERIALS + HEAD + 36 {
        return;
    }
    let header = crc32(&file[..92]).to_le_bytes();
    file[92..96].copy_from_slice(&header);
    let starts = sections(file);
    let mut checksums: Vec<[u8; 4]> = Vec::new();
    for start in &starts {
        let length = u32::from_le_bytes(file[start + 4..start + 8].try_into().unwrap()) as usize;
        let end = (start + HEAD + length).min(file.len());
        if file[*start..].starts_with(b"INDX") && file[start + 26] == 0 {
            let counts = 16 * (usize::from(file[4]) + 1);
            for (entry, checksum) in (start + HEAD + counts + 28..end).step_by(32).zip(&checksums) {
                if let Some(field) = file.get_mut(entry..entry + 4) {
                    field.copy_from_slice(checksum);
                }
            }
        }
        let parts = [&file[*start..start + 28], &file[start + HEAD..end]].concat();
        let checksum = crc32(&parts).to_le_bytes();
        file[start + 28..start + 32].copy_from_slice(&checksum);
        if file[*start..].starts_with(b"TREE") {
            checksums.push(checksum);
        }
    }
    let trailer = file.len() - 36;
    let checksum = crc32(&file[trailer..trailer + 32]).to_le_bytes();
    file[trailer + 32..].copy_from_slice(&checksum);
}
