//! Messages between the middleware and the session.
//!
//! r2r keeps the ten oldest messages of a subscription that nobody takes and drops newer ones without a word. So every subscription is
//! emptied after every spin, which adds one message at most, into a queue of ours, which keeps the newest and counts what it drops.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use futures::FutureExt;
use futures::stream::{BoxStream, Stream, StreamExt, unfold};
use tokio::sync::Notify;

/// To be called after every spin of the node.
pub(crate) type Emptying = Box<dyn FnMut() + Send>;

/// A queue that drops its oldest message when it is full.
pub(crate) struct Inbox<T> {
    waiting: Mutex<VecDeque<(Instant, T)>>,
    capacity: usize,
    dropped: AtomicU64,
    arrived: Notify,
}

impl<T: Send + 'static> Inbox<T> {
    pub(crate) fn new(capacity: usize) -> Arc<Self> {
        Arc::new(Self { waiting: Mutex::default(), capacity, dropped: AtomicU64::new(0), arrived: Notify::new() })
    }

    /// A new queue for `stream`: what is in it, with the time it arrived, and what empties the stream into it.
    pub(crate) fn emptying(
        mut stream: impl Stream<Item = T> + Unpin + Send + 'static,
        capacity: usize,
    ) -> (Arc<Self>, BoxStream<'static, (Instant, T)>, Emptying) {
        let inbox = Self::new(capacity);
        let filled = Arc::clone(&inbox);
        let empty = move || {
            while let Some(Some(message)) = stream.next().now_or_never() {
                filled.put(Instant::now(), message);
            }
        };
        (Arc::clone(&inbox), inbox.messages(), Box::new(empty))
    }

    fn put(&self, now: Instant, message: T) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() == self.capacity {
            waiting.pop_front();
            tracing::debug!(message = std::any::type_name::<T>(), "dropped, because newer ones came");
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
        waiting.push_back((now, message));
        self.arrived.notify_one();
    }

    fn messages(self: Arc<Self>) -> BoxStream<'static, (Instant, T)> {
        unfold(self, |inbox| async {
            loop {
                let next = inbox.waiting.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
                match next {
                    Some(message) => return Some((message, inbox)),
                    None => inbox.arrived.notified().await,
                }
            }
        })
        .boxed()
    }

    /// How many were dropped so far.
    pub(crate) fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn the_newest_are_kept_and_the_rest_is_counted() {
        let inbox = Inbox::new(2);
        (0..5).for_each(|number| inbox.put(Instant::now(), number));
        let kept: Vec<i32> = Arc::clone(&inbox).messages().take(2).map(|(_, number)| number).collect().await;
        assert_eq!((kept, inbox.dropped()), (vec![3, 4], 3));
        // Whoever waits is woken.
        let waiting = tokio::spawn(Arc::clone(&inbox).messages().take(1).collect::<Vec<_>>());
        inbox.put(Instant::now(), 7);
        assert_eq!(waiting.await.unwrap()[0].1, 7);
        // A stream is emptied to what it has, without waiting.
        let (mut sender, receiver) = futures::channel::mpsc::channel(10);
        let (inbox, messages, mut empty) = Inbox::emptying(receiver, 5);
        (0..10).for_each(|number| sender.try_send(number).unwrap());
        empty();
        assert_eq!(inbox.dropped(), 5);
        assert_eq!(messages.take(5).map(|(_, number)| number).collect::<Vec<_>>().await, [5, 6, 7, 8, 9]);
    }
}
