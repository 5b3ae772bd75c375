"""Peng, Lee and Cao: crowds with levels of detail on the GPU."""
