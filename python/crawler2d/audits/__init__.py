"""Audits: what a model of a robot lacks, where it seizes, and what smallest change ends that."""
