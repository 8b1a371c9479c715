"""The known failures of photon density estimation, as tiny scenes with their right answers."""
