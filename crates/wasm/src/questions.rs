//! Questions by name, and their answers.
//!
//! | question | asks | answer |
//! | --- | --- | --- |
//! | `vectors` | | name of the level of vectors that the module is compiled for |
//! | `presets` | | names of the looks |
//! | `check` | `{kind, text}` | a document, if it is valid |
//! | `patch` | `{document, operations}` | the document with the operations done |
//! | `volume` | | name, size, type, range, facts |
//! | `samples` | | bytes of all samples, x fastest |
//! | `kind` | | kind of data, and why |
//! | `look` | `{auto}`, `{preset}` or `{document}` | name, reason and document of the look |
//! | `scene` | `{document}` | size and camera of the document's picture |
//! | `camera` | `{fit}`, `{view}`, `{orbit}`, `{turned}`, `{zoomed}` or `{document}` | the camera |
//! | `draw` | `{size, quality}` | RGBA, 8 bits, straight alpha |
//! | `floats` | | the last picture: premultiplied RGBA, 32 bits |
//! | `slice` | `{origin, across, down, size, slab}` | values on a plane, 32 bits |

use serde_json::{Value, json};
use wavesplat::look::presets;

use crate::documents;
use crate::opened::OpenedVolume;
use crate::requests::{parsed, text};

/// An answer: a text, most often JSON, or numbers.
pub enum Answer {
    /// Bytes, such as a text or pixels.
    Bytes(Vec<u8>),
    /// Samples, where they lie.
    Samples(&'static [u8]),
    /// Floats.
    Floats(Vec<f32>),
}

impl Answer {
    /// JSON as its text.
    pub fn text(value: &Value) -> Self {
        Self::Bytes(value.to_string().into_bytes())
    }

    /// The bytes of the answer, aligned as its numbers.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Samples(bytes) => bytes,
            Self::Floats(floats) => bytemuck::cast_slice(floats),
        }
    }
}

/// The answer to a question. `opened`: the volume, if there is one.
///
/// # Errors
///
/// A message for whoever asked.
pub fn answer(opened: &mut Option<OpenedVolume>, question: &str, asked: &[u8]) -> Result<Answer, String> {
    let asked = parsed(asked)?;
    match question {
        "vectors" => return Ok(Answer::text(&wavesplat::simd_in_use().into())),
        "presets" => return Ok(Answer::text(&presets::names().collect())),
        "check" => {
            let checked = documents::checked(text(&asked, "kind", "")?, text(&asked, "text", "")?)?;
            return Ok(Answer::text(&checked));
        }
        "patch" => return Ok(Answer::text(&documents::changed(&asked["document"], &asked["operations"])?)),
        _ => {}
    }
    let Some(opened) = opened else { return Err(format!("no volume is open; open one before '{question}'")) };
    match question {
        "volume" => Ok(Answer::text(&opened.described())),
        "samples" => Ok(Answer::Samples(opened.sample_bytes())),
        "kind" => {
            let found = opened.kind();
            Ok(Answer::text(&json!({"kind": found.kind.name(), "reason": found.reason, "is_guess": found.is_guess()})))
        }
        "look" => opened.set_look(&asked).map(|look| Answer::text(&look)),
        "scene" => opened.set_scene(&asked["document"]).map(|scene| Answer::text(&scene)),
        "camera" => opened.set_camera(&asked).map(|camera| Answer::text(&camera)),
        "draw" => opened.draw(&asked).map(Answer::Bytes),
        "floats" => opened.floats().map(Answer::Floats),
        "slice" => opened.slice(&asked).map(Answer::Floats),
        _ => Err(format!("there is no question '{question}'")),
    }
}
