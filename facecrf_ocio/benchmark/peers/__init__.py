"""Other software that does a part of this, on the same pictures: `facecrf bench peers`."""
