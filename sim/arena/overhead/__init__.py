"""The picture of a camera above the floor, with the tags by which a tracker finds the robots: painted by a process of
its own, like what robots see (sim/arena/cameras), while somebody looks. docs/protocol-camera.md.
"""
