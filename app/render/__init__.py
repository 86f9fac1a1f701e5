"""Reports as text and as HTML pages; nothing here computes or chooses words."""
