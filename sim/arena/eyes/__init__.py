"""What the virtual robots see: pictures painted by a process of its own while somebody looks (docs/protocol-camera.md)."""
