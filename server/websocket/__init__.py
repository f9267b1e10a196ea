"""The WebSocket side of rosbridge (RFC 6455): who is let in, frames, turns, and clients that are slow or rude."""
