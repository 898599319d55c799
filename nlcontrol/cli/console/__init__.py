"""The console that commands share: options, output, files and lines typed at a prompt."""
