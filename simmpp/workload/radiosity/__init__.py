"""Radiosity: matt patches light each other, by rays that patches send out."""
