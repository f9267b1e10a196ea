"""The SD card with which a robot or a master begins."""
