"""What is replayed and measured: camera traces and logs."""
