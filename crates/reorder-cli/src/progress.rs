//! A bar for people who wait, on a terminal only.

use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// Nothing is drawn for work that takes less.
const PATIENCE: Duration = Duration::from_secs(1);
const TICK: Duration = Duration::from_millis(100);
/// The spans that the library and this command open, in the order in which they first come.
const PHASES: [&str; 4] = ["reading", "spanning tree", "certificate", "search"];

/// Does the work, and shows its phase on standard error once it takes longer than a second.
pub(crate) fn with_progress<T>(work: impl FnOnce() -> T) -> T {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    let bar = ProgressBar::with_draw_target(Some(PHASES.len() as u64), ProgressDrawTarget::hidden());
    if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:16}] {msg} ({elapsed})") {
        bar.set_style(style);
    }
    let (done, waiting) = channel::<()>();
    let shown = bar.clone();
    let shower = std::thread::spawn(move || {
        if waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
            shown.set_draw_target(ProgressDrawTarget::stderr());
            shown.enable_steady_tick(TICK);
        }
    });
    let result = tracing::subscriber::with_default(Phases { bar: bar.clone() }, work);
    drop(done);
    let _ = shower.join();
    bar.finish_and_clear();
    result
}

/// Moves the bar on when a span of [`PHASES`] is entered.
struct Phases {
    bar: ProgressBar,
}

impl Subscriber for Phases {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_span() && PHASES.contains(&metadata.name())
    }
    /// A phase is its own span: nobody asks for one after it is left.
    fn new_span(&self, span: &Attributes<'_>) -> Id {
        let phase = PHASES.iter().position(|&name| name == span.metadata().name());
        Id::from_u64(phase.unwrap_or(0) as u64 + 1)
    }
    fn enter(&self, span: &Id) {
        let phase = span.into_u64();
        self.bar.set_position(self.bar.position().max(phase));
        self.bar.set_message(PHASES[phase as usize - 1]);
    }
    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn event(&self, _: &Event<'_>) {}
    fn exit(&self, _: &Id) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_follows_the_library_through_its_phases() {
        use planner::reorder::{Options, order};
        use planner::se3_geom::{R2, nalgebra::Vector2};
        let bar = ProgressBar::with_draw_target(Some(4), ProgressDrawTarget::hidden());
        let crossing: Vec<_> =
            (0..40).map(|k| (0.16 * f64::from(k)).sin_cos()).map(|(s, c)| Vector2::new(s, s * c)).collect();
        for (n, phase) in [(8, "certificate"), (40, "search")] {
            let phases = Phases { bar: bar.clone() };
            tracing::subscriber::with_default(phases, || order(&R2::default(), &crossing[..n], &Options::default()))
                .expect("an order");
            assert_eq!(
                bar.position(),
                PHASES.iter().position(|&name| name == phase).map_or(0, |k| k as u64 + 1),
                "{n}"
            );
        }
        assert!(PHASES[1..].contains(&bar.message().as_str()));
    }
}
