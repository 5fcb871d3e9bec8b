"""Workloads: all rays of a picture with the objects they have to be tested against."""
