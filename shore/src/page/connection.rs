//! TCP connections to browsers: limited in number, with read and write time-outs.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep, sleep};

/// The most connections at a time; more wait to be accepted.
const CONNECTIONS_MAX: usize = 192;
/// A connection on which nothing arrives for so long is closed. Websockets are pinged more often.
const SILENCE: Duration = Duration::from_secs(60);
/// A connection that accepts no bytes for so long, while there are some to send, is closed.
const DEAF: Duration = Duration::from_secs(20);
/// How long to wait after the system could not accept.
const AGAIN: Duration = Duration::from_millis(200);

/// Accepts connections.
pub(super) struct Listener {
    listener: TcpListener,
    free: Arc<Semaphore>,
}

impl Listener {
    /// Accepts from this listener.
    pub(super) fn new(listener: TcpListener) -> Listener {
        Listener { listener, free: Arc::new(Semaphore::new(CONNECTIONS_MAX)) }
    }

    /// A permit for one more connection.
    async fn place(&self) -> Option<OwnedSemaphorePermit> {
        Arc::clone(&self.free).acquire_owned().await.ok()
    }

    /// The next connection.
    pub(super) async fn accept(&self) -> Connection {
        loop {
            let place = self.place().await;
            match (place, self.listener.accept().await) {
                (Some(place), Ok((stream, _))) => {
                    // A frame is one small write; waiting for more only makes it late.
                    drop(stream.set_nodelay(true));
                    return Connection { stream, silence: Box::pin(sleep(SILENCE)), deaf: None, _place: place };
                }
                _ => sleep(AGAIN).await,
            }
        }
    }
}

/// A connection to a browser.
pub(super) struct Connection {
    stream: TcpStream,
    silence: Pin<Box<Sleep>>,
    /// Ends the wait for a browser to take something, while there is one.
    deaf: Option<Pin<Box<Sleep>>>,
    _place: OwnedSemaphorePermit,
}

impl Connection {
    /// The result of an attempt to write, or a time-out.
    fn written(&mut self, context: &mut Context<'_>, tried: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        if tried.is_ready() {
            self.deaf = None;
            return tried;
        }
        let deaf = self.deaf.get_or_insert_with(|| Box::pin(sleep(DEAF)));
        deaf.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncRead for Connection {
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

impl AsyncWrite for Connection {
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
