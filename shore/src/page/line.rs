//! The lines to browsers: no more than so many, and none that is silent for ever.

use axum::serve::Listener;
use std::io;
use std::net::SocketAddr;
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
}

impl Listener for Quay {
    type Io = Line;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Line, SocketAddr) {
        loop {
            let place = self.place().await;
            match (place, self.listener.accept().await) {
                (Some(place), Ok((stream, from))) => {
                    // A frame is one small write; waiting for more only makes it late.
                    drop(stream.set_nodelay(true));
                    return (Line { stream, silence: Box::pin(sleep(SILENCE)), _place: place }, from);
                }
                _ => sleep(AGAIN).await,
            }
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

/// A line to a browser.
pub(super) struct Line {
    stream: TcpStream,
    silence: Pin<Box<Sleep>>,
    _place: OwnedSemaphorePermit,
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
        Pin::new(&mut self.stream).poll_write(context, bytes)
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
        Pin::new(&mut self.stream).poll_write_vectored(context, slices)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
