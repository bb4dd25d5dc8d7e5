//! Materials that an OBJ file gives to whole groups in a table behind its faces.
//!
//! Files of Viewpoint's early models do not put `usemtl` before the faces that it is for. They name the groups of the
//! faces with `g`, and end with pairs of a statement `group NAME`, which the format does not know, and `usemtl MATERIAL`.

use std::collections::HashMap;

/// How much of the end of a file is searched for the table.
const TABLE_BYTES: usize = 1 << 16;

/// The material of each group, by name.
#[derive(Debug, Default)]
pub(crate) struct GroupMaterials(HashMap<Vec<u8>, Vec<u8>>);

impl GroupMaterials {
    /// Reads the table at the end of the text of an OBJ file, if there is one.
    pub(crate) fn find(bytes: &[u8]) -> Self {
        let mut materials = HashMap::new();
        let mut group = None;
        for line in bytes[bytes.len().saturating_sub(TABLE_BYTES)..].split(|&byte| byte == b'\n') {
            let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            match (words.next(), words.next()) {
                (Some(b"group"), Some(name)) => group = Some(name),
                (Some(b"usemtl"), Some(material)) => {
                    if let Some(group) = group.take() {
                        materials.insert(group.to_vec(), material.to_vec());
                    }
                }
                _ => {}
            }
        }
        Self(materials)
    }

    /// The material of the first of some groups that has one; `names` are separated by blanks.
    pub(crate) fn of(&self, names: &[u8]) -> Option<&[u8]> {
        if self.0.is_empty() {
            return None;
        }
        names.split(u8::is_ascii_whitespace).find_map(|name| self.0.get(name)).map(Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_group_and_material_are_found() {
        let text = b"v 0 0 0\ng hat\nf 1 1 1\n\ngroup hat\nusemtl felt\r\ngroup shoe\nusemtl leather\nusemtl stray\n";
        let materials = GroupMaterials::find(text);
        assert_eq!(materials.of(b" hat"), Some(&b"felt"[..]));
        assert_eq!(materials.of(b" left shoe\r"), Some(&b"leather"[..]));
        assert_eq!(materials.of(b" stray"), None);
    }

    #[test]
    fn ordinary_files_have_no_table() {
        let materials = GroupMaterials::find(b"g hat\nusemtl felt\nf 1 2 3\n");
        assert_eq!(materials.of(b"hat"), None);
    }
}
