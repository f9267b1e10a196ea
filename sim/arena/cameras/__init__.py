"""What the virtual robots see: pictures that a process of their own paints while somebody looks.

The arena's side: `pages` (HTTP), `streams` (who looks), `painter_process`. That process: `__main__`, `picture` and all
that a picture is made of. Both: `scene`, what one tells the other. docs/protocol-camera.md.
"""
