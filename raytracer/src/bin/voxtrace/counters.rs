//! What the processor itself counts while it works, where the machine allows.

/// Events on all threads of the current pool.
#[derive(Debug, Clone, Copy, Default)]
pub struct Events {
    pub cycles: u64,
    pub instructions: u64,
    /// Accesses to memory that no cache could answer.
    pub cache_misses: u64,
    pub branch_misses: u64,
}

#[cfg(target_os = "linux")]
mod of_threads {
    use super::Events;
    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter, Group};
    use std::io;

    /// The counters of one thread, which count together.
    struct OfThread {
        group: Group,
        counters: [Counter; 4],
    }

    impl OfThread {
        /// For the current thread.
        fn open() -> io::Result<Self> {
            let mut group = Group::new()?;
            let mut add = |event| add(&mut group, event);
            let counters = [
                add(Hardware::CPU_CYCLES)?,
                add(Hardware::INSTRUCTIONS)?,
                add(Hardware::CACHE_MISSES)?,
                add(Hardware::BRANCH_MISSES)?,
            ];
            Ok(Self { group, counters })
        }
    }

    fn add(group: &mut Group, event: impl Event) -> io::Result<Counter> {
        group.add(&Builder::new(event))
    }

    /// Counters of all threads of the current pool.
    pub struct Counters(Vec<OfThread>);

    impl Counters {
        /// # Errors
        /// If the machine has none, or does not let this program read them.
        pub fn open() -> io::Result<Self> {
            rayon::broadcast(|_| OfThread::open()).into_iter().collect::<io::Result<_>>().map(Self)
        }

        /// What happens during some work.
        ///
        /// # Errors
        /// If the counters cannot be read.
        pub fn count<T>(&mut self, work: impl FnOnce() -> T) -> io::Result<(T, Events)> {
            for OfThread { group, .. } in &mut self.0 {
                group.reset()?;
                group.enable()?;
            }
            let result = work();
            let mut events = Events::default();
            for OfThread { group, counters } in &mut self.0 {
                group.disable()?;
                let counts = group.read()?;
                let [cycles, instructions, cache_misses, branch_misses] =
                    counters.each_ref().map(|counter| counts[counter]);
                events.cycles += cycles;
                events.instructions += instructions;
                events.cache_misses += cache_misses;
                events.branch_misses += branch_misses;
            }
            Ok((result, events))
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod of_threads {
    use super::Events;
    use std::io;

    /// There are none.
    pub enum Counters {}

    impl Counters {
        /// # Errors
        /// Always.
        pub fn open() -> io::Result<Self> {
            Err(io::Error::new(io::ErrorKind::Unsupported, "they are only read on Linux"))
        }

        /// # Errors
        /// None.
        pub fn count<T>(&mut self, _: impl FnOnce() -> T) -> io::Result<(T, Events)> {
            match *self {}
        }
    }
}

pub use of_threads::Counters;
