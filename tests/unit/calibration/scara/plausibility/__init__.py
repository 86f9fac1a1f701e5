"""The gate before a result: mistakes that it names, and sound measurements that it lets pass."""
