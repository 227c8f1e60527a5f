"""What a point cloud is taken from: built-in solids, each in a file of its own, and the user's."""
