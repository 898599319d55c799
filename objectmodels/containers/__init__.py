"""What pouring and lids do: forces, flow, places."""
