"""Everything that runs on a robot's Raspberry Pi; virtual robots run the same code unchanged."""
