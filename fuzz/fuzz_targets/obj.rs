//! Any bytes as an OBJ file that three objects of a scene share.
#![no_main]

#[path = "../../tests/common/untrusted.rs"]
mod untrusted;

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use untrusted::Folder;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::new);

fuzz_target!(|bytes: &[u8]| {
    FOLDER.obj(bytes);
});
