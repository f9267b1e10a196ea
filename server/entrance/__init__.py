"""One entrance to many arenas: who has free robots, and the way there. No arena needs it."""
