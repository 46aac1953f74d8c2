"""Roadwatch's own networks: trained on simulated images only, exported for the daemon, and scored."""

import os

# Read when PyTorch is loaded. Its threads would otherwise spin while they wait for one another, which
# beside any other busy process slows training tenfold (measured: 8.4 against 0.8 images/s).
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
