"""Machine code: of which source it is, where it is kept, and how it is put together."""
