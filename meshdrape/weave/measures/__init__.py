"""What is measured on a net, cell by cell, and what its own mesh falsifies."""
