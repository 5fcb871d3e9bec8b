"""The simulated machine at work: one model of a PE, and the engines that drive it."""
