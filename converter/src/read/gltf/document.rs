//! From bytes to a document in which every index leads somewhere.

use ::gltf::json::Root;
use ::gltf::json::validation::Checked;
use ::gltf::{Document, Gltf, Semantic};

/// Length of a GLB file's header, in bytes.
const GLB_HEADER: u32 = 12;

/// The document of a glTF or GLB file, and the buffer within a GLB.
pub(super) fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), String> {
    let invalid = |error: ::gltf::Error| format!("no valid glTF 2.0 file: {error}");
    check_announced_length(bytes)?;
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(invalid)?;
    let json = document.into_json();
    check_positions(&json)?;
    Ok((Document::from_json(json).map_err(invalid)?, blob))
}

/// Refuses a GLB that says it is shorter than its header: `gltf` subtracts one from the other.
fn check_announced_length(bytes: &[u8]) -> Result<(), String> {
    match bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..)?.first_chunk()) {
        Some(&length) if u32::from_le_bytes(length) < GLB_HEADER => Err(format!(
            "no valid glTF 2.0 file: the header announces {} bytes, but has {GLB_HEADER} itself",
            u32::from_le_bytes(length)
        )),
        _ => Ok(()),
    }
}

/// Refuses positions in accessors that do not exist: the validation of `gltf-json` 1.4 looks into them unchecked.
fn check_positions(json: &Root) -> Result<(), String> {
    let count = json.accessors.len();
    for (mesh_index, mesh) in json.meshes.iter().enumerate() {
        for (primitive_index, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(accessor) = primitive.attributes.get(&Checked::Valid(Semantic::Positions))
                && accessor.value() >= count
            {
                return Err(format!(
                    "mesh {mesh_index}, primitive {primitive_index}: POSITION is accessor {}, but the file has {count}",
                    accessor.value()
                ));
            }
        }
    }
    Ok(())
}
