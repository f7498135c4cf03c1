//! The functions of the module, and its memory. They are called on one thread.
#![allow(unsafe_code, reason = "addresses come from the host")]

use std::cell::RefCell;
use std::panic::set_hook;
use std::sync::Once;

use crate::opened::OpenedVolume;
use crate::questions::{Answer, answer};
use crate::requests::parsed;

thread_local! {
    static OPENED: RefCell<Option<OpenedVolume>> = const { RefCell::new(None) };
    static ANSWER: RefCell<Answer> = const { RefCell::new(Answer::Bytes(Vec::new())) };
}

/// Room for `n` bytes, which a call takes; null where there is no memory.
#[unsafe(no_mangle)]
pub extern "C" fn ws_alloc(n: usize) -> *mut u8 {
    let mut bytes: Vec<u8> = Vec::new();
    if bytes.try_reserve_exact(n).is_err() {
        return std::ptr::null_mut();
    }
    bytes.resize(n, 0);
    Box::into_raw(bytes.into_boxed_slice()).cast()
}

/// The bytes that the host has written.
///
/// # Safety
///
/// `at` is of [`ws_alloc`], for `n` bytes, and is not used again.
unsafe fn taken(at: *mut u8, n: usize) -> Vec<u8> {
    // SAFETY: as above.
    unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, n)) }.into_vec()
}

/// Gives room back that no call has taken.
///
/// # Safety
///
/// As for [`ws_open`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ws_free(at: *mut u8, n: usize) {
    // SAFETY: as above.
    drop(unsafe { taken(at, n) });
}

/// Opens a NIfTI or NRRD file: its name and its bytes. 0, or 1 for an error.
///
/// # Safety
///
/// Each address is of [`ws_alloc`], for as many bytes, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ws_open(name: *mut u8, name_len: usize, file: *mut u8, file_len: usize) -> u32 {
    // SAFETY: as above.
    let [name, file] = unsafe { [taken(name, name_len), taken(file, file_len)] };
    opened(|| OpenedVolume::read(&String::from_utf8_lossy(&name), &file))
}

/// Opens samples: JSON of their size, type and place, and their bytes. 0, or 1 for an error.
///
/// # Safety
///
/// As for [`ws_open`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ws_open_samples(head: *mut u8, head_len: usize, bytes: *mut u8, bytes_len: usize) -> u32 {
    // SAFETY: as above.
    let [head, bytes] = unsafe { [taken(head, head_len), taken(bytes, bytes_len)] };
    opened(|| OpenedVolume::of_samples(&parsed(&head)?, bytes))
}

/// Asks a question: its name and its JSON. 0, or 1 for an error.
///
/// # Safety
///
/// As for [`ws_open`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ws_ask(question: *mut u8, question_len: usize, asked: *mut u8, asked_len: usize) -> u32 {
    // SAFETY: as above.
    let [question, asked] = unsafe { [taken(question, question_len), taken(asked, asked_len)] };
    kept_result(|| OPENED.with_borrow_mut(|opened| answer(opened, &String::from_utf8_lossy(&question), &asked)))
}

/// Address of the last answer, or of the message of the last error.
#[unsafe(no_mangle)]
pub extern "C" fn ws_answer() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.bytes().as_ptr())
}

/// The number of bytes of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn ws_answer_len() -> usize {
    ANSWER.with_borrow(|answer| answer.bytes().len())
}

/// Opens the volume of an instance.
fn opened(open: impl FnOnce() -> Result<OpenedVolume, String>) -> u32 {
    kept_result(|| {
        OPENED.with_borrow_mut(|opened| {
            if opened.is_some() {
                return Err("a volume is open already; the next one needs a new instance".to_owned());
            }
            let volume = opened.insert(open()?);
            Ok(Answer::text(&volume.described()))
        })
    })
}

/// Keeps the answer of a call, or the message of its error.
fn kept_result(call: impl FnOnce() -> Result<Answer, String>) -> u32 {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| set_hook(Box::new(|panic| keep(Answer::Bytes(panic.to_string().into_bytes())))));
    // A call that ends by a trap without a panic leaves no answer: memory was refused.
    keep(Answer::Bytes(Vec::new()));
    let (is_error, answer) = match call() {
        Ok(answer) => (0, answer),
        Err(message) => (1, Answer::Bytes(message.into_bytes())),
    };
    keep(answer);
    is_error
}

fn keep(answer: Answer) {
    ANSWER.with(|kept| {
        if let Ok(mut kept) = kept.try_borrow_mut() {
            *kept = answer;
        }
    });
}
