//! The bytes that a glTF file is made of besides its text.

use crate::read::named_file::{find_file, read_file};
use ::gltf::Document;
use ::gltf::buffer::{Source, View};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Base 64 with or without padding: programs write both.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The buffers of a document.
pub(super) struct Resources {
    folder: PathBuf,
    buffers: Vec<Vec<u8>>,
}

impl Resources {
    /// Reads the buffers of the document of a file. The error says which one cannot be read, and why.
    pub(super) fn load(path: &Path, document: &Document, mut blob: Option<Vec<u8>>) -> Result<Self, String> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut resources = Self { folder, buffers: Vec::new() };
        for buffer in document.buffers() {
            let name = format!("buffer {}", buffer.index());
            let bytes = match buffer.source() {
                Source::Bin => blob.take().ok_or_else(|| format!("{name} is not in the file"))?,
                Source::Uri(uri) => resources.read_uri(uri).map_err(|error| format!("{name}: {error}"))?,
            };
            if bytes.len() < buffer.length() {
                return Err(format!(
                    "{name} has {} bytes, but {} are announced; it is incomplete",
                    bytes.len(),
                    buffer.length()
                ));
            }
            resources.buffers.push(bytes);
        }
        Ok(resources)
    }

    /// The bytes that a URI contains or names.
    pub(super) fn read_uri(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, data) = data.split_once(',').ok_or("the data URI has no data")?;
            return if kind.ends_with(";base64") {
                BASE64.decode(data).map_err(|error| format!("the data URI is damaged: {error}"))
            } else {
                Ok(percent_decode_str(data).collect())
            };
        }
        let name: Cow<'_, str> =
            percent_decode_str(uri.strip_prefix("file://").unwrap_or(uri)).decode_utf8_lossy();
        let path = find_file(&self.folder, &name);
        read_file(&path).map_err(|error| format!("{}: cannot read it: {error}", path.display()))
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, view: &View<'_>) -> Result<&[u8], String> {
        let bytes = self.buffers.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        bytes.zip(end).and_then(|(bytes, end)| bytes.get(view.offset()..end)).ok_or_else(|| {
            format!(
                "buffer view {} of {} bytes from {} on reaches beyond its buffer",
                view.index(),
                view.length(),
                view.offset()
            )
        })
    }
}
