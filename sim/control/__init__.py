"""TraceRecorder and free motion."""
