"""Files and folders: written whole or not at all, strict JSON, versions, threads of processes."""
