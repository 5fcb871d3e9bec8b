"""Workloads kept between runs."""
