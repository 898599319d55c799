"""Pouring and lids: forces, flow, places."""
