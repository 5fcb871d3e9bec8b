"""Figures as data, and how they are drawn: for print and for pages."""
