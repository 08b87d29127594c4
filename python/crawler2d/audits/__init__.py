"""Audits: mistakes in a model of a robot, where it seizes, and the smallest repair."""
