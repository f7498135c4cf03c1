//! Wavesplat as a module of WebAssembly: a volume, its look and its camera, drawn on one thread.
//!
//! An instance holds one volume; the next one gets a new instance, since memory that an instance has had is its own for
//! good. `web/src/engine/module.ts` is the host. The functions of the module are those of [`abi`]: the host writes bytes
//! into memory of the module, asks, and reads the answer. Questions and answers are JSON ([`questions`]), pixels and
//! samples are bytes.
//!
//! ```text
//! ws_alloc(n) -> at            room for n bytes of a question; 0 where there is no memory
//! ws_open(name, file)          the volume of a NIfTI or NRRD file
//! ws_open_samples(head, bytes) the volume of samples that the host has read
//! ws_ask(question, json)       see `questions`
//! ws_answer() -> at            the last answer, or the message of the last error
//! ws_answer_len() -> n
//! ```
//!
//! `ws_open`, `ws_open_samples` and `ws_ask` give 0 for an answer, 1 for an error. A panic traps: its message is the last
//! answer, and the instance must not be used any more.

pub mod abi;
pub mod documents;
pub mod opened;
pub mod questions;
mod requests;
