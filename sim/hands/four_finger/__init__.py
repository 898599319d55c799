"""The four-finger hand: its joints, figures and postures, which nothing outside knows."""
