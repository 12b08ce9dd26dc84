"""What a diagnosis says: names with intervals, the repaired model, the gap shrinking, files and sentences."""
