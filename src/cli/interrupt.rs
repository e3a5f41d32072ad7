//! Ctrl-C and its like. The only file that names `ctrlc`.

use super::Exit;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wavetrace::render::Control;

/// What an interruption does: before the render it ends the program; during it, the render, so that the image so far
/// can be written; the second time it ends the program in any case.
#[derive(Debug, Default)]
pub struct Interrupt {
    rendering: AtomicBool,
    control: Control,
}

impl Interrupt {
    /// Listens from now on. Where the system does not allow that, an interruption ends the program.
    pub fn listen() -> Arc<Self> {
        let interrupt = Arc::new(Self::default());
        let handler = Arc::clone(&interrupt);
        let _ = ctrlc::set_handler(move || handler.on_signal());
        interrupt
    }
    /// From now on there is something to save. Returns how the render is watched and stopped.
    pub fn start_render(&self) -> &Control {
        self.rendering.store(true, Ordering::SeqCst);
        &self.control
    }
    /// Whether the user interrupted.
    pub fn happened(&self) -> bool {
        self.control.is_stopped()
    }
    fn on_signal(&self) {
        if !self.rendering.load(Ordering::SeqCst) || self.control.is_stopped() {
            process::exit(Exit::Interrupted as i32);
        }
        self.control.stop();
    }
}
