"""Yarn-yarn contact on smooth surfaces and at edges."""
