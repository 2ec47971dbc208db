//! The lines to browsers: no more than so many, and none that is silent for ever.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep, sleep};

/// The most lines at a time; more wait to be accepted.
const LINES_MAX: usize = 192;
/// A line on which nothing comes for so long is cut. Websockets are asked for a sign of life more often.
const SILENCE: Duration = Duration::from_secs(60);
/// A line that takes nothing for so long, while there is something for it, is cut.
const DEAF: Duration = Duration::from_secs(20);
/// How long to wait when the system has no line to give.
const AGAIN: Duration = Duration::from_millis(200);

/// Where lines come from.
pub(super) struct Quay {
    listener: TcpListener,
    free: Arc<Semaphore>,
}

impl Quay {
    /// All lines come from here.
    pub(super) fn new(listener: TcpListener) -> Quay {
        Quay { listener, free: Arc::new(Semaphore::new(LINES_MAX)) }
    }

    /// A place for one more line; nothing while there is none.
    async fn place(&self) -> Option<OwnedSemaphorePermit> {
        Arc::clone(&self.free).acquire_owned().await.ok()
    }

    /// The next line.
    pub(super) async fn accept(&self) -> Line {
        loop {
            let place = self.place().await;
            match (place, self.listener.accept().await) {
                (Some(place), Ok((stream, _))) => {
                    // A frame is one small write; waiting for more only makes it late.
                    drop(stream.set_nodelay(true));
                    return Line { stream, silence: Box::pin(sleep(SILENCE)), deaf: None, _place: place };
                }
                _ => sleep(AGAIN).await,
            }
        }
    }
}

/// A line to a browser.
pub(super) struct Line {
    stream: TcpStream,
    silence: Pin<Box<Sleep>>,
    /// Ends the wait for a browser to take something, while there is one.
    deaf: Option<Pin<Box<Sleep>>>,
    _place: OwnedSemaphorePermit,
}

impl Line {
    /// What comes of an attempt to write, unless attempts have been in vain for too long.
    fn written(&mut self, context: &mut Context<'_>, tried: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        if tried.is_ready() {
            self.deaf = None;
            return tried;
        }
        let deaf = self.deaf.get_or_insert_with(|| Box::pin(sleep(DEAF)));
        deaf.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncRead for Line {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let line = &mut *self;
        match Pin::new(&mut line.stream).poll_read(context, into) {
            Poll::Pending => line.silence.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into())),
            ready => {
                line.silence.as_mut().reset(Instant::now() + SILENCE);
                ready
            }
        }
    }
}

impl AsyncWrite for Line {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let tried = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.written(context, tried)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let tried = Pin::new(&mut self.stream).poll_write_vectored(context, slices);
        self.written(context, tried)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
