"""What the virtual robots see: pictures that a process of their own paints while somebody looks.

The arena's side: `pages` (HTTP), `streams` (who looks), `painter_process`; they also serve the camera above the floor
(sim/arena/overhead). That process: `__main__`, `painting`, `picture` and all that a picture is made of. Both: `scene`,
what one tells the other. docs/protocol-camera.md.
"""
