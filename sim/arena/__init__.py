"""The arena: the physical world of the virtual robots. It knows hardware only: wheels, IR light and walls."""
