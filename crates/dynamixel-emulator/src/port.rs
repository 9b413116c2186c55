//! A bus behind a pseudo-terminal.

use crate::bus::{Bus, Transmission};
use crate::error::Error;
use nix::errno::Errno;
use nix::fcntl::{F_SETFD, F_SETFL, FdFlag, OFlag, fcntl};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use nix::unistd::{read, ttyname, write};
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What simulated time follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// The wall clock: answers come when a real bus would bring them.
    WallClock,
    /// The traffic: answers come at once, and time goes on by what they take on the wire, and by [`Bus::advance`] through
    /// [`EmulatedPort::with_bus`]. A silent bus stands still.
    BusTime,
}

/// A port that a master opens by its path, and the thread that serves it.
pub struct EmulatedPort {
    path: PathBuf,
    bus: Arc<Mutex<Bus>>,
    stop: Arc<AtomicBool>,
    server: Option<JoinHandle<()>>,
}

impl EmulatedPort {
    /// Puts a bus behind a new pseudo-terminal.
    ///
    /// # Errors
    /// When the system has no pseudo-terminal or no thread left.
    pub fn open(bus: Bus, timing: Timing) -> Result<Self, Error> {
        let failed = |what| move |source: Errno| Error::Terminal { what, source: source.into() };
        let pty = openpty(None, None).map_err(failed("open"))?;
        let mut settings = tcgetattr(&pty.slave).map_err(failed("ask"))?;
        cfmakeraw(&mut settings);
        tcsetattr(&pty.slave, SetArg::TCSANOW, &settings).map_err(failed("set"))?;
        fcntl(&pty.master, F_SETFL(OFlag::O_NONBLOCK)).map_err(failed("set"))?;
        // Child processes must not hold the port open when it is unplugged.
        for end in [&pty.master, &pty.slave] {
            fcntl(end, F_SETFD(FdFlag::FD_CLOEXEC)).map_err(failed("set"))?;
        }
        let path = ttyname(&pty.slave).map_err(failed("name"))?;
        let (bus, stop) = (Arc::new(Mutex::new(bus)), Arc::new(AtomicBool::new(false)));
        let server = Server { master: pty.master, _slave: pty.slave, bus: bus.clone(), stop: stop.clone() };
        let thread = std::thread::Builder::new().name("emulated port".to_owned());
        let thread = thread.spawn(move || server.run(timing));
        let thread = thread.map_err(|source| Error::Terminal { what: "serve", source })?;
        Ok(Self { path, bus, stop, server: Some(thread) })
    }

    /// What a master opens: `/dev/pts/N`.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Looks at the bus or changes it, between two packets.
    pub fn with_bus<R>(&self, f: impl FnOnce(&mut Bus) -> R) -> R {
        f(&mut lock(&self.bus))
    }

    /// Closes the port as if its cable was pulled: whoever has it open is hung up on. The bus may come back behind another port.
    #[must_use]
    pub fn unplug(self) -> Bus {
        let bus = Arc::clone(&self.bus);
        drop(self);
        let bus = Arc::into_inner(bus).expect("the server, which shared it, has ended");
        bus.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for EmulatedPort {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(server) = self.server.take() {
            match server.join() {
                // What broke the bus, such as its plant, must not pass for a port that was closed.
                Err(panic) if !std::thread::panicking() => std::panic::resume_unwind(panic),
                _ => {}
            }
        }
    }
}

/// A panic of somebody who held the bus leaves it between two steps; it can go on.
fn lock(bus: &Mutex<Bus>) -> MutexGuard<'_, Bus> {
    bus.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How long the server waits for bytes before it lets time pass, or looks whether it is to stop.
const PATIENCE: Duration = Duration::from_millis(1);

/// After so many turns without a byte a host is done with its packet, whole or not, though no time passes on a silent bus. Far less
/// than any host waits for an answer.
const PAUSE_TURNS: u32 = 20;

/// More than any packet of the SDK.
const PORTION: usize = 1024;

/// Sleeps for so long, but not longer than the server's patience.
fn nap(seconds: f64) {
    std::thread::sleep(PATIENCE.min(Duration::try_from_secs_f64(seconds).unwrap_or_default()));
}

struct Server {
    master: OwnedFd,
    /// Kept open, or the master gets an error whenever no host has the port open.
    _slave: OwnedFd,
    bus: Arc<Mutex<Bus>>,
    stop: Arc<AtomicBool>,
}

impl Server {
    fn run(self, timing: Timing) {
        let (started, origin_s) = (Instant::now(), lock(&self.bus).now_s());
        let wall_s = || origin_s + started.elapsed().as_secs_f64();
        let mut waiting: Vec<Transmission> = Vec::new();
        let mut silent_turns = 0;
        while !self.stop.load(Ordering::Relaxed) {
            let ahead_s = lock(&self.bus).now_s() - wall_s();
            let bytes = if timing == Timing::WallClock && ahead_s > 0.0 {
                // What is on the wire already comes first.
                nap(ahead_s);
                Vec::new()
            } else {
                if waiting.is_empty() {
                    self.wait_for_bytes();
                }
                let Ok(bytes) = self.read() else { return };
                bytes
            };
            let mut bus = lock(&self.bus);
            let now_s = wall_s();
            if timing == Timing::WallClock {
                let behind_s = now_s - bus.now_s();
                bus.advance(behind_s);
            }
            silent_turns = if bytes.is_empty() { silent_turns + 1 } else { 0 };
            if timing == Timing::BusTime && silent_turns == PAUSE_TURNS {
                bus.pause();
            }
            if !bytes.is_empty() {
                if let Some(baud) = self.baud() {
                    bus.set_host_baud(baud);
                }
                waiting.extend(bus.receive(&bytes));
                // Late packets may be overtaken.
                waiting.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
            }
            if timing == Timing::BusTime {
                for transmission in waiting.drain(..) {
                    let to_come_s = transmission.at_s - bus.now_s();
                    bus.advance(to_come_s);
                    self.write(&transmission.bytes);
                }
                // Answers that are lost take their time too.
                let to_come_s = bus.wire_free_s() - bus.now_s();
                bus.advance(to_come_s);
                continue;
            }
            drop(bus);
            let due = waiting.iter().take_while(|transmission| transmission.at_s <= now_s).count();
            waiting.drain(..due).for_each(|transmission| self.write(&transmission.bytes));
            if let Some(next) = waiting.first() {
                nap(next.at_s - wall_s());
            }
        }
    }

    fn wait_for_bytes(&self) {
        let timeout = PollTimeout::try_from(PATIENCE).unwrap_or(PollTimeout::ZERO);
        let _ = poll(&mut [PollFd::new(self.master.as_fd(), PollFlags::POLLIN)], timeout);
    }

    /// What the host has sent, a portion at a time: nobody else gets at the bus while it is simulated.
    fn read(&self) -> Result<Vec<u8>, Errno> {
        let mut portion = [0; PORTION];
        match read(&self.master, &mut portion) {
            Ok(count) => Ok(portion[..count].to_vec()),
            Err(Errno::EAGAIN | Errno::EINTR) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// What a host does not fetch is lost once the terminal's buffer is full, as in a UART.
    fn write(&self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            match write(&self.master, bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(Errno::EINTR) => {}
                Err(_) => return,
            }
        }
    }

    /// The baud rate that the host has set on its end, which both ends of a pseudo-terminal know.
    #[cfg(target_os = "linux")]
    #[allow(unsafe_code)]
    fn baud(&self) -> Option<u32> {
        nix::ioctl_read_bad!(tcgets2, nix::libc::TCGETS2, nix::libc::termios2);
        // SAFETY: the kernel fills all of a termios2 that lives until the call returns; all of its bit patterns are values. The portable
        // tcgetattr does not know rates beyond the old constants, which some masters set.
        let settings = unsafe {
            let mut settings = std::mem::zeroed();
            tcgets2(self.master.as_raw_fd(), &raw mut settings).map(|_| settings)
        };
        settings.ok().map(|settings| settings.c_ospeed)
    }

    /// Elsewhere the host is believed to have set the servos' rate.
    #[cfg(not(target_os = "linux"))]
    fn baud(&self) -> Option<u32> {
        let _ = self.master.as_raw_fd();
        None
    }
}
