"""From a file to a `Photo`: what the file says, and nothing added."""
