//! What a measurement was made on and with. The only file that names `sysinfo`.

use crate::lanes;
use std::thread;
use sysinfo::{CpuRefreshKind, System};

/// The machine, as far as the system tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Processors that the program may use.
    pub cores: usize,
    /// Name and version of the operating system.
    pub system: String,
}

impl Machine {
    /// The one that runs this.
    pub fn here() -> Self {
        let mut system = System::new();
        system.refresh_cpu_list(CpuRefreshKind::nothing());
        let cpu = system.cpus().first().map(|cpu| cpu.brand().trim().to_owned()).filter(|brand| !brand.is_empty());
        Self {
            cpu: cpu.unwrap_or_else(|| "unknown".to_owned()),
            cores: thread::available_parallelism().map_or(1, usize::from),
            system: System::long_os_version().unwrap_or_else(|| std::env::consts::OS.to_owned()),
        }
    }
}

/// This build of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Build {
    /// Version of the program.
    pub version: &'static str,
    /// Commit it was built from, with a plus sign where files differed from it; known of release builds of a checkout.
    pub commit: Option<&'static str>,
    /// `release` or `debug`.
    pub profile: &'static str,
    /// The compiler and its version.
    pub compiler: &'static str,
    /// The processor that it was compiled for: a level of x86-64 such as `x86-64-v3`, or another architecture.
    pub target: &'static str,
    /// The instruction set that kernels use on this machine.
    pub simd: &'static str,
}

impl Build {
    /// The one that runs.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("WAVETRACE_COMMIT").filter(|commit| !commit.is_empty()),
            profile: env!("WAVETRACE_PROFILE"),
            compiler: env!("WAVETRACE_COMPILER"),
            target: env!("WAVETRACE_TARGET"),
            simd: lanes::simd(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machine_and_build_are_known() {
        let machine = Machine::here();
        assert!(machine.cores > 0 && !machine.cpu.is_empty() && !machine.system.is_empty(), "{machine:?}");
        #[cfg(target_os = "linux")]
        assert_ne!(machine.cpu, "unknown");
        let build = Build::this();
        assert!(build.compiler.starts_with("rustc ") && ["debug", "release"].contains(&build.profile), "{build:?}");
        assert!(!build.target.is_empty() && (cfg!(not(target_arch = "x86_64")) || build.target.starts_with("x86-64")));
    }
}
