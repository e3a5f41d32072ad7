//! Any bytes as a scene file, beside a few small meshes that it may name.
#![no_main]

#[path = "../../tests/common/untrusted.rs"]
mod untrusted;

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use untrusted::Folder;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::new);

fuzz_target!(|bytes: &[u8]| {
    FOLDER.scene(bytes);
});
