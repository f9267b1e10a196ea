"""A WebSocket server (RFC 6455): who is let in, frames, fair scheduling, and clients that are slow or rude."""
